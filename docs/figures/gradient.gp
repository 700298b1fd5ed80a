# gnuplot -c gradient.gp FOLDER: the force of a blow and its derivatives, as SVG.
load ARG0[1:strlen(ARG0)-strlen('gradient.gp')].'style.gp'
set terminal svg size 1000,520 font 'sans-serif,14' background rgb 'white' dynamic
set multiplot layout 2,1
set lmargin 12
set xrange [0.1:1.1]
set title 'Force of a blow at 2.5 m/s, 44.1 kHz'
set ylabel 'force [N]'
plot ARG1.'/gradient' using 1:2 with lines lt -1 notitle
set title 'Its derivatives: lines exact, points by differences of two blows'
set xlabel 'time [ms]'
set ylabel '[N s/m], [N]'
plot ARG1.'/gradient' using 1:3 with lines lt 2 title 'by the speed [N s/m]', '' using 1:5 with points pt 7 ps 0.4 lc rgb '#0072b2' notitle, \
     '' using 1:4 with lines lt 3 title 'by the stiffness ratio [N]', '' using 1:6 with points pt 7 ps 0.4 lc rgb '#d55e00' notitle
unset multiplot

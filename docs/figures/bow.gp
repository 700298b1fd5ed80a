# gnuplot -c bow.gp FOLDER: the velocity of a bowed string at three normal forces, as SVG.
load ARG0[1:strlen(ARG0)-strlen('bow.gp')].'style.gp'
set terminal svg size 1000,640 font 'sans-serif,14' background rgb 'white' dynamic
set multiplot layout 3,1
set lmargin 12
set xrange [0:17]
set ytics 40
set yrange [-130:30]
set ylabel 'velocity [cm/s]'
set title 'A D string under a bow that moves at 10 cm/s, pressed by 0.07 N: it slips several times in a period'
plot ARG1.'/bow' index 0 using 1:2 with lines lt 2 notitle
set title 'by 0.3 N: it slips once'
plot ARG1.'/bow' index 1 using 1:2 with lines lt 2 notitle
set ytics 100
set yrange [-400:100]
set title 'by 1.5 N: its motion is irregular'
set xlabel 'time [ms]'
plot ARG1.'/bow' index 2 using 1:2 with lines lt 2 notitle
unset multiplot

# gnuplot -c ears.gp FOLDER: a blow on a frame drum at two ears, as SVG.
load ARG0[1:strlen(ARG0)-strlen('ears.gp')].'style.gp'
set terminal svg size 1000,480 font 'sans-serif,14' background rgb 'white' dynamic
set multiplot layout 2,1
set lmargin 10
set title 'A blow on a frame drum of 50 cm'
set ylabel 'force of the stick [N]'
set xrange [0:12]
plot ARG1.'/ears' using 1:2 with lines lt -1 notitle
set title 'Sound pressure 1.2 m away, 0.6 rad off its axis, at two ears'
set xlabel 'time [ms], less the travel time to the nearest place'
set ylabel 'pressure [Pa]'
plot ARG1.'/ears' using 1:3 with lines lt 2 title 'left', '' using 1:4 with lines lt 3 title 'right'
unset multiplot

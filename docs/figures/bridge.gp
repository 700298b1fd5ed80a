# gnuplot -c bridge.gp FOLDER: forces along a curved bridge and the steps of the solver, as SVG.
load ARG0[1:strlen(ARG0)-strlen('bridge.gp')].'style.gp'
set terminal svg size 1000,560 font 'sans-serif,14' background rgb 'white' dynamic
set multiplot
set lmargin at screen 0.09
set rmargin at screen 0.86
set xrange [20.6:29.4]
set origin 0, 0.32
set size 1, 0.68
set title 'A string over twelve points of a curved bridge: the force of each point'
set ylabel 'point of the bridge'
set yrange [0.5:12.5]
set palette defined (0 'white', 0.15 '#9ecae1', 0.5 '#0072b2', 1 '#08306b')
set cblabel 'force [N]'
unset grid
plot ARG1.'/bridge' using 1:2:3 with image notitle
set grid
set origin 0, 0
set size 1, 0.34
set title 'Newton steps in each sample, of 64 that are allowed'
set xlabel 'time [ms]'
set ylabel 'steps'
set yrange [0:10]
set ytics 5
plot ARG1.'/steps' using 1:2 with impulses lt 2 notitle
unset multiplot

# gnuplot -c stable.gp FOLDER: a hammer at a barrier, by the contact step and by an explicit step, as SVG.
load ARG0[1:strlen(ARG0)-strlen('stable.gp')].'style.gp'
set terminal svg size 1000,380 font 'sans-serif,14' background rgb 'white' dynamic
set title 'A hammer of 3 g at a wall, 44.1 kHz: speed after the blow over the speed before it'
set logscale xy
set format x '10^{%T}'
set xlabel 'stiffness, times that of the felt C4'
set ylabel 'speed after / before'
set yrange [0.5:1000]
set key top left
plot ARG1.'/stable' using 1:3 with lines lt 3 title 'explicit step (symplectic Euler)', '' using 1:2 with lines lt 2 lw 3 title 'contact step'

# gnuplot -c body.gp FOLDER: the decay of strings on a soundboard, as SVG.
load ARG0[1:strlen(ARG0)-strlen('body.gp')].'style.gp'
set terminal svg size 1000,380 font 'sans-serif,14' background rgb 'white' dynamic
set title 'C4 on a soundboard: level of the first partial in the motion of the bridge'
set xlabel 'time [s]'
set ylabel 'level [dB]'
set xrange [0:5.5]
set yrange [-75:10]
plot ARG1.'/body' using 1:2 with lines lt 3 title 'one string: one decay', '' using 1:3 with lines lt 2 title 'three strings, 0.2 and 0.3 cents apart: fast, then slow'

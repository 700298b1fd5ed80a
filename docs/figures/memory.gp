# gnuplot -c memory.gp IMPACTS: force over compression from contactspline impact --trace, as SVG.
load ARG0[1:strlen(ARG0)-strlen('memory.gp')].'style.gp'
set terminal svg size 1000,420 font 'sans-serif,14' background rgb 'white' dynamic
set datafile separator ','
set title 'A felt with memory: force over compression, in and out of a blow'
set xlabel 'compression [mm]'
set ylabel 'force [N]'
set key top left
speeds = '0.5 1 2 4'
f(c, s, m) = (column(2) == s && strcol(3) eq m) ? column(c) : NaN
plot for [i=1:4] ARG1 skip 2 using (f(6, word(speeds, i)+0, 'exact')*1000):(f(7, word(speeds, i)+0, 'exact')) with lines lt 1 lw 3 title (i == 1 ? 'exact motion' : ''), \
     for [i=1:4] ARG1 skip 2 using (f(6, word(speeds, i)+0, 'simulated') >= 0 ? f(6, word(speeds, i)+0, 'simulated')*1000 : NaN):(f(7, word(speeds, i)+0, 'simulated')) with points pt 7 ps 0.35 lc rgb '#0072b2' title (i == 1 ? 'samples at 44.1 kHz; blows at 0.5, 1, 2 and 4 m/s' : '')

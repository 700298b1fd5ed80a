# gnuplot -c stretch.gp FOLDER: the pitch of a string that stretches, as it fades, as SVG.
load ARG0[1:strlen(ARG0)-strlen('stretch.gp')].'style.gp'
set terminal svg size 1000,420 font 'sans-serif,14' background rgb 'white' dynamic
set title 'A string of 110 Hz that begins at 4, 2 and 1 mm: its pitch while it fades'
set xlabel 'time [s]'
set ylabel 'above 110 Hz [cents]'
plot for [i=0:2] ARG1.'/stretch' index i using 1:3 with lines lt 1 lw 3 title (i == 0 ? "Duffing's closed form at each amplitude" : ''), \
     for [i=0:2] ARG1.'/stretch' index i using 1:2 every 2 with points pt 7 ps 0.35 lc rgb '#0072b2' title (i == 0 ? 'periods at 44.1 kHz' : '')

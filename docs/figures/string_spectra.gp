# gnuplot -c string_spectra.gp DATA: what string_spectra_data prints, as SVG.
load ARG0[1:strlen(ARG0)-strlen('string_spectra.gp')].'style.gp'
set terminal svg size 1000,620 font 'sans-serif,14' background rgb 'white' dynamic
set multiplot layout 2,1
set lmargin 10
set xrange [0:20]
set ylabel 'velocity of the partial [dB, 1 m/s]'
set yrange [-130:10]
set title 'C4 struck at 0.5 m/s, 44.1 kHz'
plot ARG1 index 0 using ($1/1000):4 with linespoints lt 1 lw 5 pt 7 ps 0.3 title 'exact law, continuous time', '' index 0 using ($1/1000):2 with linespoints lt 3 pt 7 ps 0.3 title 'version 0.1.0: mass kept, 32 uniform segments', '' index 0 using ($1/1000):3 with linespoints lt 2 pt 7 ps 0.3 title 'now: exact compliance, 32 segments for the spectrum'
set title 'struck at 4 m/s'
set xlabel 'frequency [kHz]'
set yrange [-130:20]
plot ARG1 index 1 using ($1/1000):4 with linespoints lt 1 lw 5 pt 7 ps 0.3 notitle, '' index 1 using ($1/1000):2 with linespoints lt 3 pt 7 ps 0.3 notitle, '' index 1 using ($1/1000):3 with linespoints lt 2 pt 7 ps 0.3 notitle
unset multiplot

# gnuplot -c middle_c.gp FOLDER: what piano_features_data writes there, as SVG.
load ARG0[1:strlen(ARG0)-strlen('middle_c.gp')].'style.gp'
set terminal svg size 1000,620 font 'sans-serif,14' background rgb 'white' dynamic
stats ARG1.'/waveform_ff' using (abs($2)) name 'ff' nooutput
stats ARG1.'/waveform_pp' using (abs($2)) name 'pp' nooutput
set multiplot layout 2,1
set lmargin 10
set title 'Middle C on the soundboard, mean of both ears: the first 100 ms, each level by its peak'
set xlabel 'time [ms]'
set ylabel 'velocity / peak'
set xrange [0:100]
set yrange [-1.1:1.6]
set ytics 0.5
plot ARG1.'/waveform_ff' using 1:($2/ff_max) with lines lt 3 title 'ff, 4 m/s', \
     ARG1.'/waveform_pp' using 1:($2/pp_max) with lines lt 2 title 'pp, 0.5 m/s'
set title 'Spectrum of the first second'
set xlabel 'frequency [kHz]'
set ylabel 'velocity [dB, 1 mm/s]'
set xrange [0:6]
set yrange [-110:20]
set ytics 20
plot ARG1.'/spectrum_ff' using ($1/1000):2 with lines lt 3 title 'ff, 4 m/s', \
     ARG1.'/spectrum_mf' using ($1/1000):2 with lines lt 1 title 'mf, 1.5 m/s', \
     ARG1.'/spectrum_pp' using ($1/1000):2 with lines lt 2 title 'pp, 0.5 m/s'
unset multiplot

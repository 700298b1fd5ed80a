# gnuplot -c phantom.gp WITH WITHOUT: spectra of E1 with longitudinal modes and without, as SVG.
load ARG0[1:strlen(ARG0)-strlen('phantom.gp')].'style.gp'
set terminal svg size 1000,400 font 'sans-serif,14' background rgb 'white' dynamic
set title 'E1 on the body: phantom partials between the partials of the string'
set xlabel 'frequency [Hz]'
set ylabel 'level [dB, full scale]'
set xrange [660:840]
set yrange [-110:-20]
plot ARG1 with lines lt 2 title 'with longitudinal modes', ARG2 with lines lt 1 title 'without'

# gnuplot -c stiff_hammer.gp DATA: what stiff_hammer_data prints, as SVG.
load ARG0[1:strlen(ARG0)-strlen('stiff_hammer.gp')].'style.gp'
set terminal svg size 1000,620 font 'sans-serif,14' background rgb 'white' dynamic
set multiplot layout 2,1
set lmargin 10
set yrange [-1:3]
set ylabel 'string below the hammer [mm]'
set title 'felt of C4, 2.5 m/s: the same stroke'
plot ARG1 using 1:6 with lines lt 1 dt 2 title 'furthest bend the blow has energy for', '' using 1:2 with lines lt 3 title 'fd.hammer', '' using 1:3 with lines lt 2 title 'HammerString'
set xlabel 'time [ms]'
set yrange [-5:5]
set title 'felt a thousand times as stiff: fd.hammer makes energy'
plot ARG1 using 1:6 with lines lt 1 dt 2 notitle, '' using 1:4 with lines lt 3 notitle, '' using 1:5 with lines lt 2 notitle
unset multiplot

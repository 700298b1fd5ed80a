# gnuplot -c bowing.gp CELLS: Schelleng's and Guettler's diagrams of bowed strings, from `bowing cells`, as SVG.
load ARG0[1:strlen(ARG0)-strlen('bowing.gp')].'style.gp'
set terminal svg size 1000,520 font 'sans-serif,14' background rgb 'white' dynamic
set multiplot layout 1,2
set key outside bottom center horizontal samplen 1
set pointsize 0.6
set samples 2
set bmargin 8
at(x, kind) = column(3) == kind ? x : NaN
set title 'A violin''s D string under a bow that moves at 10 cm/s'
set xlabel 'place of the bow, parts of the length'
set ylabel 'force [N]'
set logscale xy
set xrange [0.027:0.222]
set yrange [0.008:8]
set xtics (0.03, 0.05, 0.1, 0.2)
plot ARG1 index 0 using (at($1, 2)):2 with points pt 7 lc rgb '#0072b2' title 'one slip a period', \
  '' index 0 using (at($1, 1)):2 with points pt 7 lc rgb '#e69f00' title 'several', \
  '' index 0 using (at($1, 3)):2 with points pt 7 lc rgb '#d55e00' title 'irregular', \
  '' index 0 using (at($1, 0)):2 with points pt 7 lc rgb '#d0d0d0' title 'none', \
  0.073/x with lines lw 1.6 lc rgb '#000000' title 'limits, measured', \
  0.00042/x**2 with lines lw 1.6 lc rgb '#000000' notitle
unset logscale
set title 'A cello''s D string that starts under a bow'
set xlabel 'acceleration [m/s²]'
set ylabel 'force [N]'
set xrange [0:3.15]
set yrange [0:3.15]
set xtics 1
set ytics 1
start(x, from, to) = column(3) >= from && column(3) < to ? x : NaN
plot ARG1 index 1 using (start($1, 0, 1.001)):2 with points pt 7 lc rgb '#0072b2' title 'perfect', \
  '' index 1 using (start($1, 1.001, 25)):2 with points pt 7 lc rgb '#9ecae1' title 'within 25 periods', \
  '' index 1 using (start($1, 25, 26)):2 with points pt 7 lc rgb '#d0d0d0' title 'not', \
  '+' using (1.56):(1.73) with points pt 1 ps 1.6 lw 2 lc rgb '#000000' title 'measured: perfect', \
  '+' using (1.56):(0.84) with points pt 2 ps 1.6 lw 2 lc rgb '#000000' title 'never'
unset multiplot

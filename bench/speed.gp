# gnuplot -c speed.gp STYLE FOLDER: what bench/report writes there, as speed.svg and speed_scaling.svg beside it.
load ARG1
set linetype 4 lc rgb '#009e73' lw 1.6
set linetype 5 lc rgb '#cc79a7' lw 1.6
set linetype 6 lc rgb '#e69f00' lw 1.6
set terminal svg size 1000,760 font 'sans-serif,14' background rgb 'white' dynamic
set datafile missing 'NaN'

set output ARG2.'/speed.svg'
set multiplot layout 2,2
set style data histograms
set style histogram clustered gap 1
set style fill solid border lc rgb '#ffffff'
set logscale y
set yrange [3:3000]
set ylabel 'ns a sample'
set xtics scale 0 font ',10'
set xrange [-0.5:3.5]
set key top left maxrows 3 font ',10' width -4
do for [precision in 'double float'] {
  do for [model in 'C4 C2'] {
    set title model.', '.precision
    plot for [i=2:8] ARG2.'/'.model.'_'.precision.'.dat' using i:xtic(stringcolumn(1)[1:9] eq 'permanent' ? 'permanent' : stringcolumn(1)) title columnheader(i) lc rgb word('#0072b2 #d55e00 #e69f00 #009e73 #cc79a7 #b8b8b8 #555555', i - 1)
    unset key
  }
}
unset multiplot

set output ARG2.'/speed_scaling.svg'
set lmargin 10
set multiplot layout 2,2
set style data linespoints
set xtics scale 0.5 font ',12'
set xrange [8:1024]
set pointsize 0.5
set logscale x 2
set format x '%.0f'
set key top left maxrows 10 font ',11' width 0
set yrange [2:4000]
set xlabel 'modes'
do for [precision in 'double float'] {
  set title 'modes, struck every 10 ms, '.precision
  plot ARG2.'/modes_'.precision.'.dat' using 1:2 title 'spline' lt 2, '' using 1:3 title 'EXP-3' lt 3, '' using 1:5 title 'Newton' lt 4, '' using 1:7 title 'string alone' lt 1, '' using 1:8 title 'roofline' lt -1 dt 2
}
set xrange [4:4096]
set yrange [*:*]
unset logscale y
set yrange [0:*]
double(name) = ARG2.'/'.name.'_double.dat'
float(name) = ARG2.'/'.name.'_float.dat'
set xlabel 'segments'
set title 'segments, permanent contact'
plot double('segments') using 1:2 title 'MB1, double' lt 2, float('segments') using 1:2 title 'MB1, float' lt 2 dt 2, double('segments') using 1:3 title 'C4, double' lt 3, float('segments') using 1:3 title 'C4, float' lt 3 dt 2
set xrange [1:1024]
set offsets 0, 0, graph 0.5, 0
set xlabel 'voices'
set title 'voices, C4 struck every second, ns a sample and voice'
plot double('voices') using 1:2 title 'spline, double' lt 2, float('voices') using 1:2 title 'spline, float' lt 2 dt 2, double('voices') using 1:3 title 'EXP-3, double' lt 3, float('voices') using 1:3 title 'EXP-3, float' lt 3 dt 2
unset multiplot

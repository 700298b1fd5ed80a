# gnuplot -c beside_the_paper.gp CURVES: error over the sample rate by scheme and case, as SVG.
load ARG0[1:strlen(ARG0)-strlen('beside_the_paper.gp')].'style.gp'
set terminal svg size 1000,340 font 'sans-serif,13' background rgb 'white' dynamic
set multiplot layout 1,4 margins 0.075,0.99,0.19,0.88 spacing 0.05,0
set logscale x 2
set logscale y 10
set xlabel 'rate, 44.1 kHz'
set format y '10^{%T}'
set xrange [0.9:18]
set xtics (1, 2, 4, 8, 16)
array titles = ['MB1: exit time, samples', 'C4: force', 'C2: force', 'slide: displacement']
do for [i=1:4] {
  set title titles[i]
  if (i == 1) { set ylabel 'error' offset 1 } else { unset ylabel }
  if (i == 1) { set key bottom left Left reverse samplen 1.5 } else { unset key }
  plot ARG1 index i-1 using 1:3 with linespoints lt 3 pt 9 ps 0.6 title 'EXP-3', \
       '' index i-1 using 1:4 with linespoints lt 1 lw 5 pt 7 ps 0.3 title 'Newton', \
       '' index i-1 using 1:2 with linespoints lc rgb '#222222' dt 2 lw 1.6 pt 6 ps 0.6 title 'reconstruction', \
       '' index i-1 using 1:5 with linespoints lt 2 lw 2.4 pt 5 ps 0.5 title 'ours'
}
unset multiplot

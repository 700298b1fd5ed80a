# gnuplot -c one_step.gp FOLDER: a coarse spline beside its law, and one contact step on it, as SVG.
load ARG0[1:strlen(ARG0)-strlen('one_step.gp')].'style.gp'
set terminal svg size 1000,400 font 'sans-serif,14' background rgb 'white' dynamic
set multiplot layout 1,2
set samples 60
set key top left
set title 'The law F = k y^{2.5} and a spline of six segments'
set xlabel 'compression y [mm]'
set ylabel 'force [N]'
set xrange [0:1.1]
plot [0:1.1] 4.5e9*(x/1000)**2.5 with lines lt 1 lw 4 title 'law', ARG1.'/knots' using ($1*1000):2 with linespoints lt 2 pt 7 ps 0.5 title 'spline'
set title 'One step: the two curves meet once'
set xlabel 'motion x over the sample [mm]'
set ylabel 'force over the sample [N]'
set key top right
set xrange [-0.2:0.5]
set yrange [0:50]
plot ARG1.'/step' using ($1*1000):2 with lines lt 2 title '(1) contact: f = [V(y_0+x) - V(y_0)]/x', '' using ($1*1000):3 with lines lt 3 title '(2) bodies: x = x_f - ξ f', ARG1.'/root' using ($1*1000):2 with points lt -1 pt 7 ps 0.7 title 'the step'
unset multiplot

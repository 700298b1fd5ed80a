# One look for every picture, that of `contactspline inspect --figure`.
set encoding utf8
set border 3 lc rgb '#888888'
set tics nomirror out scale 0.5 textcolor rgb '#444444'
set grid lc rgb '#e4e4e4' lw 1
set key top right samplen 2 textcolor rgb '#444444'
set linetype 1 lc rgb '#b8b8b8' lw 1.6
set linetype 2 lc rgb '#0072b2' lw 1.6
set linetype 3 lc rgb '#d55e00' lw 1.6

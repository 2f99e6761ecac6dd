# Penalty beside contact: error against run time. Called by make.sh with the folders tables and img.
set datafile separator comma
set terminal pngcairo size 1100,560 font 'sans,11' background rgb 'white'
set output img.'/penalty.png'
set logscale xy
set format xy '10^{%T}'
set grid
set border 3
set tics nomirror
set xlabel "run time / contact's finest run"
set ylabel 'relative error u_{L2}'
set bmargin 9
set key below maxrows 3 noenhanced
laws(body) = body eq 'bar' ? "contact 'explicit 1' 'explicit 10' 'explicit 100' 'implicit 1' 'implicit 10' 'implicit 100'" \
                           : "contact 'explicit 100' 'explicit 10000' 'explicit 1e+06' 'implicit 100' 'implicit 10000' 'implicit 1e+06'"
set multiplot layout 1,2
do for [body in "bar spring"] {
  set title body eq 'bar' ? 'Bar on a wall: meshes of 25 to 800 elements' : 'Rotating spring: time steps halved'
  plot for [k=1:7] tables.'/penalty_sweep.csv' \
    using (strcol(1) eq body && strcol(2) eq word(laws(body), k) ? $6 : NaN):5 \
    with linespoints linewidth (k == 1 ? 3 : 1.5) pointtype (k == 1 ? 7 : k < 5 ? 8 : 4) title word(laws(body), k)
}
unset multiplot

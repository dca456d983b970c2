# Where a matrix is not zero, without background: for light and dark pages.
# Needs: $entries (column,row from 0, of `side` x `side` squares), side, unknowns. Draws a PNG to stdout.

set terminal pngcairo transparent size 840,840
set datafile separator ','
set margins 0, 0, 0, 0
set xrange [-0.5:side - 0.5]
set yrange [side - 0.5:-0.5]
unset tics
unset key
set border 15 lw 1.5 lc rgb '#7f8c99'
half = 0.5
plot $entries using 1:2:(half):(half) with boxxyerror fillcolor rgb '#3f8cc4' fillstyle solid noborder

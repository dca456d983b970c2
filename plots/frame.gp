# A frame of `springstab simulate` (OBJ) as a surface with its mesh, y up, axes to one scale.
# Needs: output_file (PNG), frame (path).

set terminal pngcairo size 560,420 font 'DejaVu Sans,9' background '#ffffff'
set output output_file
set datafile separator ','

# Each face as its corners x,z,y, closed, and blank lines after it.
faces = "< awk '/^v /{x[++n]=$2; y[n]=$3; z[n]=$4} /^f /{for(k=2;k<=NF+1;++k){i=int($(k>NF?2:k)); " . \
        "print x[i]\",\"z[i]\",\"y[i]} print \"\"; print \"\"}' '" . frame . "'"

# A cube around it, so that the axes have one scale.
stats faces using 1 name 'x' nooutput
stats faces using 2 name 'z' nooutput
stats faces using 3 name 'y' nooutput
max(a, b) = a > b ? a : b
half = max(max(x_max - x_min, z_max - z_min), y_max - y_min) / 2
set xrange [(x_max + x_min) / 2 - half:(x_max + x_min) / 2 + half]
set yrange [(z_max + z_min) / 2 - half:(z_max + z_min) / 2 + half]
set zrange [(y_max + y_min) / 2 - half:(y_max + y_min) / 2 + half]

set view 68, 30, 1.6
set view equal xyz
set xyplane at (y_max + y_min) / 2 - half
unset border
unset tics
unset colorbox
unset key
set style fill solid 1 border lc rgb '#0a3d62'
set pm3d depthorder border lc rgb '#0a3d62' lw 0.4
splot faces using 1:2:3 with polygons fillcolor rgb '#8fbbdc'

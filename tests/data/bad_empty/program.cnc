% nothing
N10 G90

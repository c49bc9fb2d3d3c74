% an axis that is not there
N10 G1 X10 P90 F50 E500 E-500
N20 G1 X20

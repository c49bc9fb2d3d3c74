% variables
N10 G1 X$g_fX$ F$g_fFeed$ E500 E-500
N20 G1 Y$g_fY$

% CONTOUR
(The contour of a part as in its drawing; the controller moves the tool next to it)
(Tool: end mill D8, to the left of the contour, so D4 is its radius)
(Frame: that of the gantry in machines/gantry3.toml)
N10 G92 X0 Y0 Z20
N20 F60 E800 E-800
N30 M3
N40 G0 X80 Y60 Z5
N50 G41 D4
N60 G1 Z-2 F20
N70 G1 Y160 F60
N80 G2 X100 Y180 R20
N90 G1 X160
N100 G1 X200 Y130
N110 G1 X180 Y110
N120 G3 X180 Y80 R15
N130 G1 Y60
N140 G1 X80
N150 G1 Z5
N160 G40
N170 G0 X0 Y0 Z20
N180 M5

% BRACKET
(Bracket 150 x 158 x 12: contour, end mill D6, and one bore on a helix; the tutorial finds what is wrong with it)
(Path of the tool centre, Z0 is the top of the stock; frame of the SCARA in machines/scara2.toml)
N10 G92 X300 Y0 Z20
N20 F200 E1200 E-1200
N30 G0 X270 Y0
N40 G0 Z1
N50 G1 Z-6 F40
N60 G1 X420 F250
N70 G1 Y158
N80 G1 X290
N90 G2 X270 Y138 I0 J-20
N100 G1 Y0
N110 G0 Z10
(bore D12 near the far corner)
N120 G0 X425 Y165
N130 G0 Z1
N140 G1 Z-130 F40
N150 G3 I-3 J0
N160 G0 Z20

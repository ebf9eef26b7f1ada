// SPDX-License-Identifier: Apache-2.0
// A sheet of skin 160 x 80 x 2 mm in which two lines of 16 mm are to be cut: one along y at x = -40, one along x at
// x = 40. Beside each line lie two strips 4 mm wide, volumes "left" and "right" of it, which share no other face.
// gmsh -3 skin-wounds.geo -o skin-wounds.msh
SetFactory("OpenCASCADE");
H = 2; A = 8; B = 4; X = 40;
Box(1) = {-2 * X, -X, 0, 4 * X, 2 * X, H};
Box(2) = {-X - B, -A, 0, B, 2 * A, H};
Box(3) = {-X, -A, 0, B, 2 * A, H};
Box(4) = {X - A, 0, 0, 2 * A, B, H};
Box(5) = {X - A, -B, 0, 2 * A, B, H};
BooleanFragments{ Volume{1}; Delete; }{ Volume{2:5}; Delete; }
e = .01;
left[] = Volume In BoundingBox{-X - B - e, -A - e, -e, -X + e, A + e, H + e};
left[] += Volume In BoundingBox{X - A - e, -e, -e, X + A + e, B + e, H + e};
right[] = Volume In BoundingBox{-X - e, -A - e, -e, -X + B + e, A + e, H + e};
right[] += Volume In BoundingBox{X - A - e, -B - e, -e, X + A + e, e, H + e};
all[] = Volume{:};
all[] -= {left[], right[]};
Physical Volume("skin", 1) = {all[]};
Physical Volume("left", 2) = {left[]};
Physical Volume("right", 3) = {right[]};
// 1 mm along the lines, 6 mm far away.
Field[1] = Box; Field[1].VIn = 1; Field[1].VOut = 6; Field[1].Thickness = 25;
Field[1].XMin = -42; Field[1].XMax = -38; Field[1].YMin = -9; Field[1].YMax = 9; Field[1].ZMin = 0; Field[1].ZMax = H;
Field[2] = Box; Field[2].VIn = 1; Field[2].VOut = 6; Field[2].Thickness = 25;
Field[2].XMin = 31; Field[2].XMax = 49; Field[2].YMin = -2; Field[2].YMax = 2; Field[2].ZMin = 0; Field[2].ZMax = H;
Field[3] = Min; Field[3].FieldsList = {1, 2};
Background Field = 3;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;
Mesh.RandomSeed = 4;
Mesh.MshFileVersion = 2.2;

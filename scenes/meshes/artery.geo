// SPDX-License-Identifier: Apache-2.0
// An artery, a tube of 6 mm outside and 4 mm inside, 40 mm long, over a membrane of 40 x 1 x 24 mm; connective
// tissue, 4 mm wide, fills what is between them. y is up.
// gmsh -3 artery.geo -o artery.msh
SetFactory("OpenCASCADE");
L = 40; R = 3; r = 2; gap = 1; t = 1; W = 24; w = 4;
axis = t + gap + R;
Cylinder(1) = {0, axis, 0, L, 0, 0, R};
Cylinder(2) = {0, axis, 0, L, 0, 0, r};
BooleanDifference(3) = { Volume{1}; }{ Volume{2}; Delete; };
Box(4) = {0, t, -w / 2, L, axis - t, w};
BooleanDifference(5) = { Volume{4}; Delete; }{ Volume{1}; Delete; };
Box(6) = {0, 0, -W / 2, L, t, W};
out() = BooleanFragments{ Volume{3, 5, 6}; Delete; }{};
Physical Volume("artery", 1) = {3};
Physical Volume("connective", 2) = {5};
Physical Volume("membrane", 3) = {6};
Mesh.MeshSizeMin = 1.5; Mesh.MeshSizeMax = 1.5;
Mesh.RandomSeed = 4;
Mesh.MshFileVersion = 2.2;

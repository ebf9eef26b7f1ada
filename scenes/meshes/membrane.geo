// SPDX-License-Identifier: Apache-2.0
// A membrane of 40 x .5 x 20 mm, and what holds its right edge, 4 mm more. y is up.
// gmsh -3 membrane.geo -o membrane.msh
SetFactory("Built-in");
W = 20; t = 0.5;
x[] = {0, 40, 44};
cells[] = {40, 4};
Point(1) = {0, 0, 0}; Point(2) = {0, t, 0}; Point(3) = {0, t, W}; Point(4) = {0, 0, W};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve{2, 4} = 21; Transfinite Curve{1, 3} = 2;
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1}; Transfinite Surface{1} Alternated;
side = 1;
volumes[] = {};
For i In {0:1}
  out[] = Extrude{x[i + 1] - x[i], 0, 0}{Surface{side}; Layers{cells[i]};};
  side = out[0];
  volumes[] += out[1];
EndFor
Physical Volume("membrane", 1) = {volumes[0]};
Physical Volume("holder", 2) = {volumes[1]};
Mesh.RandomSeed = 4;
Mesh.MshFileVersion = 2.2;

// SPDX-License-Identifier: Apache-2.0
// A strip of tissue, 24 x 3 x .6 mm, on a bed of 24 x 3 x .3 mm: two layers that share their nodes.
// gmsh -3 peel-strip.geo -o peel-strip.msh
SetFactory("Built-in");
L = 24; W = 3;
z[] = {0, 0.3, 0.9};
cells[] = {1, 2};
Point(1) = {0, 0, 0}; Point(2) = {L, 0, 0}; Point(3) = {L, W, 0}; Point(4) = {0, W, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve{1, 3} = 61; Transfinite Curve{2, 4} = 8;
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
below = 1;
volumes[] = {};
For i In {0:1}
  out[] = Extrude{0, 0, z[i + 1] - z[i]}{Surface{below}; Layers{cells[i]};};
  below = out[0];
  volumes[] += out[1];
EndFor
Physical Volume("bed", 1) = {volumes[0]};
Physical Volume("strip", 2) = {volumes[1]};
Mesh.RandomSeed = 4;
Mesh.MshFileVersion = 2.2;

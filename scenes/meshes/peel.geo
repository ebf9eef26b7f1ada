// SPDX-License-Identifier: Apache-2.0
// A strip 60 x 8 x 2 mm on a bed of 60 x 8 x 4 mm; between them a layer of .6 mm that lets go.
// gmsh -3 peel.geo -o peel.msh
SetFactory("Built-in");
L = 60; W = 8;
z[] = {0, 4, 4.6, 6.6};
cells[] = {2, 1, 2};
Point(1) = {0, 0, 0}; Point(2) = {L, 0, 0}; Point(3) = {L, W, 0}; Point(4) = {0, W, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve{1, 3} = 31; Transfinite Curve{2, 4} = 5;
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1}; Transfinite Surface{1} Alternated;
below = 1;
volumes[] = {};
For i In {0:2}
  out[] = Extrude{0, 0, z[i + 1] - z[i]}{Surface{below}; Layers{cells[i]};};
  below = out[0];
  volumes[] += out[1];
EndFor
Physical Volume("bed", 1) = {volumes[0]};
Physical Volume("bond", 2) = {volumes[1]};
Physical Volume("strip", 3) = {volumes[2]};
Mesh.RandomSeed = 4;
Mesh.MshFileVersion = 2.2;

// SPDX-License-Identifier: Apache-2.0
// A sheet of skin 40 x 40 x 2 mm, finer along the row y = -.25 to .25, where it is cut.
// gmsh -3 skin.geo -o skin.msh
SetFactory("Built-in");
L = 20; C = .25;
volumes[] = {};
y[] = {-L, -C, C, L};
For i In {0:3}
  Point(10 + i) = {-L, y[i], 0}; Point(20 + i) = {L, y[i], 0};
  Line(30 + i) = {10 + i, 20 + i};
  Transfinite Curve{30 + i} = 33;
EndFor
For i In {0:2}
  Line(40 + i) = {10 + i, 11 + i}; Line(50 + i) = {20 + i, 21 + i};
  Curve Loop(60 + i) = {30 + i, 50 + i, -(31 + i), -(40 + i)};
  Plane Surface(60 + i) = {60 + i};
EndFor
Transfinite Curve{40, 50} = 9 Using Progression .75;
Transfinite Curve{41, 51} = 2;
Transfinite Curve{42, 52} = 9 Using Progression 1 / .75;
For i In {0:2}
  Transfinite Surface{60 + i} Alternated;
  out[] = Extrude{0, 0, 2}{Surface{60 + i}; Layers{2};};
  volumes[] += out[1];
EndFor
Physical Volume("skin", 1) = {volumes[]};
Mesh.RandomSeed = 4;
Mesh.MshFileVersion = 2.2;

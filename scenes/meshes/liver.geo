// SPDX-License-Identifier: Apache-2.0
// A block of liver with rounded edges, 60 x 40 x 16 mm: gmsh -3 liver.geo -o liver.msh
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 60, 40, 16};
Fillet{1}{1, 3, 5, 7}{12}
Mesh.MeshSizeMin = 3.6;
Mesh.MeshSizeMax = 3.6;
Mesh.Algorithm3D = 1;
Mesh.Optimize = 1;
Mesh.RandomSeed = 4;
Mesh.MshFileVersion = 2.2;
Physical Volume("liver", 1) = Volume{:};

// SPDX-License-Identifier: Apache-2.0
// The bodies of artery.geo, finer: an artery, a tube of 6 mm outside and 4 mm inside, 40 mm long, over a membrane of
// 40 x 1 x 24 mm; connective tissue, 4 mm wide, fills what is between them. y is up.
// gmsh -3 peel-artery.geo -o peel-artery.msh

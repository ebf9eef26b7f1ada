// SPDX-License-Identifier: Apache-2.0
// Principal values of a symmetric tensor, in the precision of element stress.

#ifdef SUNDER_FP64
const int kNewton = 2;  // 1e-16
#else
const int kNewton = 1;  // 3e-9
#endif

// s1 - s3 of a symmetric tensor, as |s| sqrt(2) cos(psi) with the unit deviator s and the part Q of
// s^2 that is normal to both s and the unit tensor: cos(3 psi) = sqrt(6) |Q|, as |dev(s^2)|^2 = 1/6.
// Invariants lose half the digits where two principal values are near each other (uniaxial tension):
// there cos(3 psi) = sqrt(1 - r^2) comes from a difference of squares; |Q| does not. The cubic
// 4 w^3 - 3 w = cos(3 psi) for w = cos(psi) in [sqrt(3)/2, 1] is well conditioned throughout. No
// arc cosine: the driver's is off by 1,300 ulp.
struct Principal {
  REAL range;     // s1 - s3
  float least;    // s3
  REAL largest;   // s1
};
Principal principal(REAL3 normal, REAL3 shear) {  // (xx, yy, zz), (xy, yz, zx)
  const REAL third = REAL(1) / REAL(3);
  const REAL mean = (normal.x + normal.y + normal.z) * third;
  normal -= mean;
  const REAL3 a = abs(normal), b = abs(shear);
  const REAL largest = max(max(a.x, max(a.y, a.z)), max(b.x, max(b.y, b.z)));
  const REAL scale = largest > REAL(0) ? REAL(1) / largest : REAL(0);
  normal *= scale;
  shear *= scale;
  const REAL size = sqrt(dot(normal, normal) + REAL(2) * dot(shear, shear));
  const REAL unit = size > REAL(0) ? REAL(1) / size : REAL(0);
  normal *= unit;
  shear *= unit;
  const REAL xy = shear.x, yz = shear.y, zx = shear.z;
  // dev(s^2), with s:s = 1.
  REAL3 n2 = REAL3(normal.x * normal.x + xy * xy + zx * zx, normal.y * normal.y + xy * xy + yz * yz,
                   normal.z * normal.z + zx * zx + yz * yz) - third;
  REAL3 s2 = REAL3(xy * (normal.x + normal.y) + zx * yz, yz * (normal.y + normal.z) + xy * zx,
                   zx * (normal.x + normal.z) + xy * yz);
  const REAL along = dot(n2, normal) + REAL(2) * dot(s2, shear);
  n2 -= along * normal;
  s2 -= along * shear;
  const REAL cos_3psi = sqrt(REAL(6) * (dot(n2, n2) + REAL(2) * dot(s2, s2)));
  // A cubic through four Chebyshev points, within 4e-5.
  REAL w = REAL(0.8660663295331917) +
           cos_3psi * (REAL(0.1653303502208454) +
                       cos_3psi * (REAL(-0.040691197422887695) +
                                   cos_3psi * REAL(0.00931968389748192)));
  [[unroll]] for (int i = 0; i < kNewton; ++i) {
    const REAL w2 = w * w;
    w -= ((REAL(4) * w2 - REAL(3)) * w - cos_3psi) / (REAL(12) * w2 - REAL(3));
  }
  const REAL length_ = largest * size;
  // s1 = sqrt(2/3) |s| cos(psi - 30 deg), where sin(3 psi) = sqrt(6) tr s^3, psi = 30 deg in tension,
  // and sin(psi) = sin(3 psi) / (4 cos(psi)^2 - 1), whose divisor is 2 to 3.
  const REAL sine = REAL(2.449489742783178) * along / (REAL(4) * w * w - REAL(1));
  const REAL lode = REAL(0.8660254037844386) * w + REAL(0.5) * sine;
  const REAL top = mean + REAL(0.816496580927726) * length_ * lode;
  const REAL range = REAL(1.4142135623730951) * length_ * w;
  return Principal(range, float(top - range), top);
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The headers and their initialisers, as a strict C99 compiler takes them: a member that was
   appended to a struct but not to its initialiser does not compile here. */
#include "api/initialisers.h"

void initialise_in_c99(struct initialised* to) {
  const struct initialised all = INITIALISED;
  *to = all;
}

/* SPDX-License-Identifier: Apache-2.0 */
/* The headers and their initialisers, as a strict C99 compiler takes them: a member that was
   appended to a struct but not to its initialiser does not compile here. */
#include "api/initialisers.h"

extern const struct initialised initialised_in_c99;
const struct initialised initialised_in_c99 = INITIALISED;

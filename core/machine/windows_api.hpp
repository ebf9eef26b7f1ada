// SPDX-License-Identifier: Apache-2.0
// windows.h without the macros that clash with the standard library's names. On Windows alone.
#pragma once

#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>

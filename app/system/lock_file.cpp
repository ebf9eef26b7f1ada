// SPDX-License-Identifier: Apache-2.0
#include "app/system/lock_file.hpp"

namespace sunder::app::system {

LockFile::Taken LockFile::take(const Folder& folder, const std::string& name,
                               std::error_code& error) {
  for (;;) {
    handle_.close();
    open(folder, name, error);
    if (!handle_.is_open()) return Taken::no;
    const Taken taken = lock(error);
    // The one before may have given it back, and removed the file, in between.
    if (taken != Taken::yes || still_there(folder, name)) return taken;
  }
}

}  // namespace sunder::app::system

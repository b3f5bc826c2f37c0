#pragma once
#include <string>

#include "palpate/core/archive.h"

/// Objects with an archive() function as bytes, bitwise: between processes of one program, and in its
/// database of results.
namespace palpate {

/// Serializes the entries of an archive that saved.
std::string to_bytes(const Archive::Values& values);
/// Returns the entries.  @throws Error where the bytes are truncated
Archive::Values values_of(const std::string& bytes);

/// Returns an object as bytes.
template <class Object>
std::string archived(Object object) {
  Archive archive;
  object.archive(archive);
  return to_bytes(archive.values());
}

/// Restores an object from archived().  @throws Error for bytes of another object, or truncated ones
template <class Object>
Object restored(const std::string& bytes) {
  Object object;
  Archive archive(values_of(bytes), "stored result");
  object.archive(archive);
  return object;
}

}  // namespace palpate

#pragma once
#include <string>

#include "render/picture.h"

namespace palpate::session {

/// Receiver of the pictures of a run in order, all of one size. It keeps no picture in memory.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// Adds a picture.  @throws Error if it cannot be written
  void add(const render::Picture& picture) {
    put(picture);
    ++written_;
  }
  /// Completes the output after the last picture.  @throws Error if it cannot be written
  virtual void close() = 0;
  /// Returns the name of the output that is missing if add() or close() failed.
  virtual std::string missing() const = 0;
  /// Returns the number of pictures added so far.
  int written() const { return written_; }

 private:
  virtual void put(const render::Picture& picture) = 0;
  int written_ = 0;
};

}  // namespace palpate::session

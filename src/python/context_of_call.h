#pragma once
#include "render/available.h"

namespace palpate::python {

/// Scope guard of a call that may draw: releases the GL context at its end, so that the next call may come
/// from another thread.
struct ContextOfCall {
  ContextOfCall() = default;
  ~ContextOfCall() { render::release_context(); }
  ContextOfCall(const ContextOfCall&) = delete;
  ContextOfCall& operator=(const ContextOfCall&) = delete;
};

}  // namespace palpate::python

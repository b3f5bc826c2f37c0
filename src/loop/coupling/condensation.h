#pragma once
#include "implicit_step.h"
#include "palpate/dynamics/linearised_contact.h"

namespace palpate::loop {

/// Linearises the contact of a tool with the response of the bodies over the next period, for `condensed`:
/// writes F0, F1, J and B of the record.
/// @param period, tick  length of the period and of the tool's ticks [s]
/// @param c  contact of the tool with nodes at the State
/// @return false if the step matrix has no factor; the record is then unchanged
bool condense(const CoupledTool& tool, StepFactor& factor, double period, double tick,
              const contact::FrameLinearisation& c, dynamics::LinearisedContact& record);

}  // namespace palpate::loop

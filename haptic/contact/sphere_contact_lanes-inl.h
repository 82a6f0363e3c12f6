// The kernels of sphere_contact_lanes.cpp; see kernel.h.
//
// Every expression is that of sphere_window.cpp, in the same order: results are bit-identical.

#include "haptic/contact/sphere_lanes_register-inl.h"

#include "haptic/contact/sphere_lanes_reached-inl.h"

#include "haptic/contact/sphere_lanes_inside-inl.h"

#include "haptic/contact/sphere_lanes_find-inl.h"

#include "haptic/contact/sphere_lanes_candidates-inl.h"

inline SphereContactKernels kernels() noexcept {
  return {reached, prepare, find, rises, steepSlopes, candidates, insides};
}

// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.h"

#include <cstddef>
#include <type_traits>

namespace rbs::python {
namespace {

static_assert(std::is_standard_layout_v<BodyId> && sizeof(BodyId) == sizeof(std::uint64_t));
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Quat) == 4 * sizeof(double));
static_assert(sizeof(Pose) == 7 * sizeof(double) && sizeof(Twist) == 6 * sizeof(double));
static_assert(offsetof(BodyState, twist) == offsetof(BodyState, pose) + sizeof(Pose));

/// Keeps memory alive for as long as Python has an array of it.
py::capsule ownerOf(std::shared_ptr<const void> memory) {
  using Owner = std::shared_ptr<const void>;
  return {new Owner(std::move(memory)), [](void* owner) { delete static_cast<Owner*>(owner); }};
}

py::array readOnly(py::array array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

constexpr auto kStride = static_cast<py::ssize_t>(sizeof(BodyState));

py::dtype contactType() {
  const auto real = py::dtype::of<double>();
  const auto handle = py::dtype::of<std::uint64_t>();
  const py::object vector = py::make_tuple(real, py::make_tuple(3));
  const auto named = [](auto... names) { return py::list(py::make_tuple(names...)); };
  return py::dtype(named("body_a", "body_b", "position", "normal", "separation", "normal_impulse",
                         "friction_impulse", "touching_steps"),
                   named(handle, handle, vector, vector, real, real, vector, py::dtype::of<std::uint64_t>()),
                   named(offsetof(ContactPoint, a), offsetof(ContactPoint, b), offsetof(ContactPoint, p_W),
                         offsetof(ContactPoint, n_W), offsetof(ContactPoint, separation),
                         offsetof(ContactPoint, normal_impulse), offsetof(ContactPoint, friction_impulse),
                         offsetof(ContactPoint, touching_steps)),
                   sizeof(ContactPoint));
}

}  // namespace

py::array columnsOf(const States& states, int first, int last) {
  const auto n = static_cast<py::ssize_t>(states->size());
  const double* begin = states->empty() ? nullptr : rowOf(states->front()) + first;
  return readOnly({py::dtype::of<double>(),
                   {n, py::ssize_t{last - first}},
                   {kStride, py::ssize_t{sizeof(double)}},
                   begin,
                   ownerOf(states)});
}

py::array idsOf(const States& states) {
  const auto n = static_cast<py::ssize_t>(states->size());
  const BodyState* begin = states->data();
  return readOnly(
      {py::dtype::of<std::uint64_t>(), {n}, {kStride}, begin ? &begin->id.serial : nullptr, ownerOf(states)});
}

py::array arrayOf(const Contacts& contacts) {
  const auto n = static_cast<py::ssize_t>(contacts->size());
  return readOnly(
      {contactType(), {n}, {py::ssize_t{sizeof(ContactPoint)}}, contacts->data(), ownerOf(contacts)});
}

}  // namespace rbs::python

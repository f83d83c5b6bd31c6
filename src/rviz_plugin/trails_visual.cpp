// SPDX-License-Identifier: BSD-3-Clause
#include "trails_visual.h"

#include <algorithm>

namespace rbs {
namespace {

constexpr std::size_t kMostPieces = 100000;

const BodyMesh& line() {
  static const BodyMesh mesh = lineMesh();
  return mesh;
}

}  // namespace

void TrailsVisual::clear() {
  ends_.clear();
  pieces_.clear();
  groups_.clear();
}

void TrailsVisual::draw(const BodyCatalog& catalog, const std::vector<BodyPlace>& places,
                        const std::vector<Ogre::ColourValue>& colors, double stamp, double seconds,
                        const Eye& eye) {
  if (stamp < stamp_) pieces_.clear(), ends_.clear();
  if (ends_.size() == places.size())
    extend(catalog, places, colors, stamp);
  else
    for (const BodyPlace& place : ends_.clear(), places) ends_.push_back(place.position);
  stamp_ = stamp;
  while (!pieces_.empty() && (stamp - pieces_.front().stamp > seconds || pieces_.size() > kMostPieces))
    pieces_.pop_front();
  groups_.begin();
  for (Piece& piece : pieces_) {
    piece.line.alpha = static_cast<float>(1.0 - (stamp - piece.stamp) / seconds);
    groups_.add(line(), Look::Plain, piece.line);
  }
  groups_.end(eye.position);
}

// A piece is as long as a tenth of the body, so that what is at rest or slow adds none.
void TrailsVisual::extend(const BodyCatalog& catalog, const std::vector<BodyPlace>& places,
                          const std::vector<Ogre::ColourValue>& colors, double stamp) {
  constexpr float kShortest = 0.1f, kSlack = 3.0f;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const CatalogBody& body = catalog.bodies[k];
    const Ogre::Vector3 way = places[k].position - ends_[k];
    const float length = way.length(), shortest = kShortest * body.reach();
    if (!body.is_dynamic || length < shortest) continue;
    const auto passed = static_cast<float>(stamp - stamp_);
    const bool has_jumped = length > shortest + kSlack * places[k].velocity.length() * passed + body.reach();
    if (!has_jumped)
      pieces_.push_back({Instance::at(ends_[k], Ogre::Vector3::UNIT_X.getRotationTo(way),
                                      Ogre::Vector3(length, 1.0f, 1.0f), colors[k]),
                         stamp});
    ends_[k] = places[k].position;
  }
}

}  // namespace rbs

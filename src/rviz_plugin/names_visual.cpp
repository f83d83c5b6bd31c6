// SPDX-License-Identifier: BSD-3-Clause
#include "names_visual.h"

#include <OgreSceneManager.h>

#include <algorithm>
#include <cmath>

namespace rbs {

NamesVisual::~NamesVisual() {
  clear();
}

void NamesVisual::clear() {
  for (Label& label : labels_) {
    label.node->detachAllObjects();
    node_.getCreator()->destroySceneNode(label.node);
  }
  labels_.clear();
}

NamesVisual::Label& NamesVisual::label(std::size_t number) {
  constexpr float kAnyHeight = 1.0f;
  while (labels_.size() <= number) {
    auto text = std::make_unique<rviz::MovableText>("-", "Liberation Sans", kAnyHeight,
                                                    Ogre::ColourValue(0.05f, 0.08f, 0.12f));
    text->setTextAlignment(rviz::MovableText::H_CENTER, rviz::MovableText::V_ABOVE);
    Ogre::SceneNode* const node = node_.createChildSceneNode();
    node->attachObject(text.get());
    labels_.push_back({node, std::move(text)});
  }
  return labels_[number];
}

void NamesVisual::draw(const BodyCatalog& catalog, const std::vector<BodyPlace>& places, const Eye& eye) {
  constexpr float kPixels = 14.0f, kLeast = 1e-4f;
  std::vector<std::pair<float, std::size_t>> near;
  for (std::size_t k = 0; k < places.size(); ++k)
    if (catalog.bodies[k].shape != BodyShape::Plane)
      near.emplace_back((places[k].position - eye.position).length(), k);
  const std::size_t count = std::min(near.size(), kMost);
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  for (std::size_t number = 0; number < count; ++number) {
    const auto [distance, k] = near[number];
    const CatalogBody& body = catalog.bodies[k];
    Label& shown = label(number);
    if (shown.text->getCaption() != body.name && !body.name.empty()) shown.text->setCaption(body.name);
    shown.text->setCharacterHeight(std::max(kLeast, kPixels * distance / eye.pixels));
    shown.node->setPosition(places[k].position + Ogre::Vector3(0.0f, 0.0f, body.reach()));
    shown.node->setVisible(true);
  }
  for (std::size_t number = count; number < labels_.size(); ++number) labels_[number].node->setVisible(false);
}

}  // namespace rbs

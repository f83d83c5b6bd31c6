// SPDX-License-Identifier: BSD-3-Clause
// The scenes of a catalogue in the list of a combo box, each with a picture and what it shows.
#pragma once

#include <QComboBox>
#include <QStringList>

namespace rbs {

/// Makes the list of a combo box show pictures and properties.
void showAsSceneList(QComboBox& box);

/// Replaces its entries. The picture of a scene is `scenes/pictures/NAME.png` of this package, if there is one.
void fillSceneList(QComboBox& box, const QStringList& names, const QStringList& properties);

}  // namespace rbs

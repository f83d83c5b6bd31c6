// SPDX-License-Identifier: BSD-3-Clause
// Writes the plots to a file: as a picture, or as a table of their numbers.
#pragma once

#include "plot_stack.h"

#include <QString>

namespace rbs {

/// The kind of file follows from the name: .png and .svg are the picture that is seen, .csv is the table of all
/// curves that are plotted, over the whole run. The file is written whole or not at all. Returns why it was not;
/// empty: it was.
QString exportPlots(const PlotStack& plots, const QString& path);

}  // namespace rbs

// SPDX-License-Identifier: BSD-3-Clause
#include "plot_export.h"

#include <qwt_plot_renderer.h>

#include <QBuffer>
#include <QFileInfo>
#include <QImage>
#include <QPainter>
#include <QSaveFile>
#include <QSvgGenerator>

#include <string>
#include <vector>

namespace rbs {
namespace {

constexpr double kPixelRatio = 2.0;  // of a picture to the screen, so that it is sharp in print

QSize sizeOf(const PlotStack& plots) {
  return plots.widget()->size();
}

void paint(const PlotStack& plots, QPainter& painter) {
  painter.fillRect(QRect(QPoint(0, 0), sizeOf(plots)), plots.palette().brush(QPalette::Window));
  QwtPlotRenderer renderer;
  renderer.setDiscardFlag(QwtPlotRenderer::DiscardBackground);
  for (TimePlot* plot : plots.plots()) renderer.render(plot, &painter, plot->geometry());
}

QByteArray pngOf(const PlotStack& plots) {
  QImage image(sizeOf(plots) * kPixelRatio, QImage::Format_RGB32);
  image.setDevicePixelRatio(kPixelRatio);
  {
    QPainter painter(&image);
    paint(plots, painter);
  }
  QBuffer bytes;
  bytes.open(QIODevice::WriteOnly);
  image.save(&bytes, "PNG");
  return bytes.data();
}

QByteArray svgOf(const PlotStack& plots) {
  QBuffer bytes;
  QSvgGenerator generator;
  generator.setOutputDevice(&bytes);
  generator.setSize(sizeOf(plots));
  generator.setViewBox(QRect(QPoint(0, 0), sizeOf(plots)));
  generator.setTitle("Plots of rigid_body_sim");
  {
    QPainter painter(&generator);
    paint(plots, painter);
  }
  return bytes.data();
}

QByteArray tableOf(const PlotStack& plots) {
  std::vector<Column> columns;
  for (const TimePlot* plot : plots.plots()) {
    const std::string unit = plot->quantity().unit.empty() ? "" : " (" + plot->quantity().unit + ")";
    for (const TimePlot::Curve& curve : plot->curves())
      columns.push_back({curve.name + unit, plots.history().present(curve.name).samples()});
  }
  return QByteArray::fromStdString(csvOf(columns));
}

}  // namespace

QString exportPlots(const PlotStack& plots, const QString& path) {
  const QString kind = QFileInfo(path).suffix().toLower();
  if (kind != "png" && kind != "svg" && kind != "csv")
    return QString("'%1' is not written: its name must end in .png, .svg or .csv.").arg(path);
  const QByteArray bytes = kind == "png" ? pngOf(plots) : kind == "svg" ? svgOf(plots) : tableOf(plots);
  QSaveFile file(path);
  if (!file.open(QIODevice::WriteOnly) || file.write(bytes) != bytes.size() || !file.commit())
    return QString("'%1' is not written: %2.").arg(path, file.errorString());
  return {};
}

}  // namespace rbs

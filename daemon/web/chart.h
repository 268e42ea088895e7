/* chart.h - drawings as SVG: the last hour, units by worker
 *
 * Colours are classes of the style sheet's, so they follow light and dark.
 * Thread: the loop's. */
#ifndef RADD_WEB_CHART_H
#define RADD_WEB_CHART_H

#include "observer/history.h"
#include "observer/markup.h"
#include "observer/units.h"

/* Rays a second and threads at work, with what the scales are. */
void chart_history(struct markup *m, const struct history *h);

/* Spans of time by worker. */
void chart_units(struct markup *m, const struct units *u);

#endif

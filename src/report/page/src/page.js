import { makeHeatMapsReadable } from "./heat.js";
import { makeTablesSortable } from "./tables.js";
import { drawCharts } from "./plots.js";

makeTablesSortable();
drawCharts();
makeHeatMapsReadable();

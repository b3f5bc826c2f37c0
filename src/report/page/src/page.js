import { makeHeatMapsReadable } from "./heat.js";
import { makeTablesSortable } from "./tables.js";
import { makePlotsLive } from "./plots.js";

makeTablesSortable();
makePlotsLive();
makeHeatMapsReadable();

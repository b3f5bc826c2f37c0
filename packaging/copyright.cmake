# Writes Debian's `copyright` file: palpate's own licence, and those of what is inside its binaries.
#
# Text of Debian's own files: of libraries that are linked in whole or whose templates are compiled in, as
# they stand on the system that builds the package.
function(palpate_write_copyright target)
  set(text "palpate: haptic rendering of deformable objects.

Copyright: the authors of palpate.
License: GPL-3+

palpate is free software: you can redistribute it and/or modify it under the terms of the GNU General Public
License as published by the Free Software Foundation, either version 3 of the License, or (at your option)
any later version.

palpate is distributed in the hope that it will be useful, but WITHOUT ANY WARRANTY; without even the implied
warranty of MERCHANTABILITY or FITNESS FOR A PARTICULAR PURPOSE.  See the GNU General Public License for more
details.

On Debian systems the full text of the GNU General Public License version 3 is in
/usr/share/common-licenses/GPL-3.

The pages that `palpate report` writes contain the following scripts.

")
  file(READ ${PROJECT_SOURCE_DIR}/src/report/page/dist/LICENSES.txt scripts)
  string(APPEND text "${scripts}
The binaries contain code of the following Debian packages besides; CGAL (libcgal-dev) is under GPL-3+ and
LGPL-3+, Eigen (libeigen3-dev) and Spectra (libspectra-dev) are under MPL-2.0, all in
/usr/share/common-licenses.
")
  foreach(package libcli11-dev libfmt-dev libqhull-dev libspdlog-dev libsundials-dev libtomlplusplus-dev
      nlohmann-json3-dev)
    set(file /usr/share/doc/${package}/copyright)
    if(EXISTS ${file})
      file(READ ${file} notice)
      string(APPEND text "
-------------------------------------------------------------------------------
${package}

${notice}")
    endif()
  endforeach()
  file(WRITE ${target} "${text}")
endfunction()

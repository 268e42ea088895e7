# see DESIGN; files of man/, one a line

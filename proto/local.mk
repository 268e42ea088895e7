# see DESIGN; files of proto/, one a line

# see DESIGN; files of etc/, one a line

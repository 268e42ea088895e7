# see DESIGN; files of doc/, one a line

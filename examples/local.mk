# see DESIGN; files of examples/, one a line

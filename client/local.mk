# see DESIGN; files of client/, one a line

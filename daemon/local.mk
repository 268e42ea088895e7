# see DESIGN; files of daemon/, one a line
